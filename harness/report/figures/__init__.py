"""Pictures of the report: one file a picture, each a function from rows or series to SVG text."""
