"""A decay for a person: tables on the terminal, and a picture."""

from harness.report.decay.picture import bands_picture, decay_picture
from harness.report.decay.terminal import print_apart, print_bands, print_decay

__all__ = ["bands_picture", "decay_picture", "print_apart", "print_bands", "print_decay"]
