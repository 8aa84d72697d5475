"""The command ``denoc``: verbs parse, call and print."""
