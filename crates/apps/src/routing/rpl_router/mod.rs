//! What a router does in a tree of RPL: its timers, its messages, and its packets.

mod forwarding;
mod messages;
mod timers;
