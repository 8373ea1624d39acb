#![no_main]

libfuzzer_sys::fuzz_target!(
    init: rayflock_fuzz::write_seeds("obj"),
    |bytes: &[u8]| rayflock_fuzz::ask("obj", bytes)
);
