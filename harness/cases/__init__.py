"""The built-in suite, one file a case, each citing its truth."""
