"""Which effects: score tests, multi-start, beam search over sets, exchange of members."""
