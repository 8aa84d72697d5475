"""What acts at a joint, as one compiled law with a row of parameter slots."""
