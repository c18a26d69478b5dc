"""The control process: connections, sessions, output lease, settings and status. It supervises the other processes."""
