"""Default time limits of the client."""

REPLY_TIMEOUT = 2.0  # for a reply, and for the confirmation of an emergency stop [s]
CHANGE_TIMEOUT = 12.0  # for a new solver or backend to be ready [s]
