"""Between drive and link: what a second encoder, behind gear or spring, shows of flexibility, play and its own errors."""
