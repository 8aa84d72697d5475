"""Hooks of the site's builder, for a site that is read from disk: nothing is fetched, and no page counts from a server's root."""

from __future__ import annotations

import re
from typing import Any

# The script by which the search works from disk is the site's own.
FETCHED = "https://unpkg.com/iframe-worker/shim"
OWN = "javascripts/iframe-worker.js"
# What the theme writes into pages that stand for any other, as 404.html does.
ROOTS = ((r'\b(href|src|action)="/(?!/)', r'\1="'), (r'"(base)": "/"', r'"\1": "."'), (r'"(search)": "/', r'"\1": "'))
SCRIPT_ROOT = 'new URL("/",location)'


def on_post_page(output: str, *, page: Any, config: Any) -> str:
    """Put the own copy where the theme names the server's; every page lies beside the folder."""
    return output.replace(FETCHED, "../" * page.url.count("/") + OWN)


def on_post_template(output_content: str, *, template_name: str, config: Any) -> str:
    """The same for pages that are no documents; they lie beside the others, and link to them so."""
    if not template_name.endswith(".html"):
        return output_content
    for root, beside in ROOTS:
        output_content = re.sub(root, beside, output_content)
    return output_content.replace(FETCHED, OWN).replace(SCRIPT_ROOT, 'new URL(".",location)')
