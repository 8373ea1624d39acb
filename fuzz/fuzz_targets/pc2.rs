#![no_main]

libfuzzer_sys::fuzz_target!(
    init: rayflock_fuzz::write_seeds("pc2"),
    |bytes: &[u8]| rayflock_fuzz::ask("pc2", bytes)
);
