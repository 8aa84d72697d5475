"""The catalogue as a page of documentation: ``python -m harness.effects.page > docs/effects.md``."""

from __future__ import annotations

import sys

from harness.effects.catalogue import catalogue
from harness.effects.effect import Effect, Family, Parameter, Plausible

INTRODUCTION = """# The catalogue of effects

What a nominal model may have left out, in the words that `denoc diagnose` uses. This page is written from the catalogue itself
(`python -m harness.effects.page > docs/effects.md`); a test keeps them equal. Parameters are in SI; what an effect adds
stands beside what the model states already.

*Typical size* is where screening and fitting begin: a factor times sizes natural to the system and the recording
(torque: the largest that gravity, or the joint's stated spring over its motion, makes there; inertia about the joint's axis;
frequency: √((gravity's torque + stiffness)/inertia) in rad/s; signal: half the channel's range; effort: the largest applied;
duration; interval between samples; gravity; mass carried; length to the tip).

*Usually* says how large a number is as a rule, the scale of a Cauchy prior: of effects that recordings cannot part, the one that
is plausible at its size is named first. It rules nothing out that recordings show.

Friction that depends on direction needs no effect of its own: T₊ one way and T₋ the other is exactly `coulomb_friction` of
(T₊ + T₋)/2 with `constant_torque` of (T₋ − T₊)/2, sliding and sticking.

## Your own

An effect of your own is a Python file of a few lines, see `examples/own_effect.py`: a name, parameters with units, and a torque.
"""


def page() -> str:
    """The page as Markdown."""
    parts = [INTRODUCTION]
    for family in Family:
        parts.append(f"## {family.value[:1].upper()}{family.value[1:]}\n")
        parts += [_section(effect) for effect in catalogue().values() if effect.family is family]
    return "\n".join(parts)


def _section(effect: Effect) -> str:
    lines = [f"### `{effect.name}`", "", f"{effect.title[:1].upper()}{effect.title[1:]}, at a {effect.site.value}.", ""]
    if effect.parameters:
        lines += ["| parameter | unit | meaning | possible | typical size |", "| --- | --- | --- | --- | --- |"]
        lines += [_row(parameter) for parameter in effect.parameters]
        lines.append("")
    lines += [
        f"- **Signature** {_sentence(effect.signature)}",
        f"- **Shown by** {_sentence(effect.shows_in)}",
        f"- **Engines** {'; '.join(f'{engine}: {how}' for engine, how in effect.expressed_by.items())}.",
    ]
    lines += [
        f"- **Usually** {_usual(parameter.name, parameter.plausible)}: {parameter.plausible.source}."
        for parameter in effect.parameters
        if parameter.plausible is not None
    ]
    if effect.plausible is not None:
        own = effect.plausible
        lines.append(f"- **Usually** {own.what} is within {own.size:g}: {own.source}.")
    if effect.modifies:
        lines.append(
            f"- **Modifies** {', '.join(f'`{name}`' for name in effect.modifies)}, or what the model states of it."
        )
    if effect.simpler:
        lines.append(f"- **Contains** {', '.join(f'`{name}`' for name in effect.simpler)}.")
    if effect.confusable_with:
        lines.append(f"- **Mistaken for** {', '.join(f'`{name}`' for name in effect.confusable_with)}.")
    lines += [f"- **Source** {effect.source}", ""]
    return "\n".join(lines)


def _usual(name: str, plausible: Plausible) -> str:
    return (
        f"1 / `{name}` is within {plausible.size}"
        if plausible.inverse
        else f"`{name}` is within {plausible.size} of absence"
    )


def _row(parameter: Parameter) -> str:
    unit = parameter.unit + (f" ({parameter.linear_unit} if prismatic)" if parameter.linear_unit else "")
    possible = f"{parameter.lower:.4g} … {parameter.upper:.4g}".replace("-inf", "−∞").replace("inf", "∞")
    meaning = parameter.what.replace("|", "\\|")
    return f"| `{parameter.name}` | {unit} | {meaning} | {possible} | {parameter.scale} |"


def _sentence(text: str) -> str:
    return text[:1].lower() + text[1:] + ("" if text.endswith(".") else ".")


if __name__ == "__main__":
    sys.stdout.write(page())
