"""What a hypothesis says the sensors should have read: batched free runs, then the measurement chain."""
