#![no_main]

libfuzzer_sys::fuzz_target!(
    init: rayflock_fuzz::write_seeds("vtp"),
    |bytes: &[u8]| rayflock_fuzz::ask("vtp", bytes)
);
