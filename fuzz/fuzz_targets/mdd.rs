#![no_main]

libfuzzer_sys::fuzz_target!(
    init: rayflock_fuzz::write_seeds("mdd"),
    |bytes: &[u8]| rayflock_fuzz::ask("mdd", bytes)
);
