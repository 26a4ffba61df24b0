"""Background jobs and the mailbox between threads."""
