#![no_main]

libfuzzer_sys::fuzz_target!(
    init: rayflock_fuzz::write_seeds("mtl"),
    |bytes: &[u8]| rayflock_fuzz::ask("mtl", bytes)
);
