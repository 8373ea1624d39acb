//! `bench`, subcommand by subcommand.

mod map;
mod museum;
