"""Public reports about ray and point queries, as small cases that exact arithmetic decides."""
