"""What may be claimed: effects judged on data held out, and their rivals."""
