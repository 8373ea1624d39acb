//! Model check of the lock on a subfield: every order in which three threads may run.
//!
//! The file under test is compiled here against the locks of the model checker.

use loom::sync::Arc;
use loom::thread;

mod lock {
    pub(super) use loom::sync::RwLock;
}

#[path = "../src/subfields/hand_over.rs"]
mod hand_over;

use hand_over::HandOver;

/// Something of a frame, and how often it was written.
#[derive(Debug)]
struct Written {
    frame: u64,
    count: u32,
}

/// Asks for the frame 1, as a ray that wants a subfield does.
fn ask(shared: &HandOver<Written>) -> (u64, u32) {
    shared.with(
        |written| written.frame == 1,
        |written| {
            written.frame = 1;
            written.count += 1;
        },
        |written| (written.frame, written.count),
    )
}

#[test]
fn whoever_asks_first_writes_once_and_all_read_what_was_written() {
    loom::model(|| {
        let shared = Arc::new(HandOver::new(Written { frame: 0, count: 0 }));
        let others: Vec<_> = (0..2)
            .map(|_| {
                let shared = Arc::clone(&shared);
                thread::spawn(move || ask(&shared))
            })
            .collect();
        assert_eq!(ask(&shared), (1, 1));
        for other in others {
            assert_eq!(other.join().unwrap(), (1, 1));
        }
    });
}

/// The model has orders in which more than one thread finds the value out of date: a hand-over that
/// does not ask again under its lock writes twice in one of them.
#[test]
#[should_panic(expected = "written twice")]
fn the_model_finds_a_hand_over_that_does_not_ask_again() {
    loom::model(|| {
        let shared = Arc::new(loom::sync::RwLock::new(Written { frame: 0, count: 0 }));
        let careless = |shared: &loom::sync::RwLock<Written>| {
            let is_current = shared.read().unwrap().frame == 1;
            if !is_current {
                let mut written = shared.write().unwrap();
                assert!(written.count == 0, "written twice");
                *written = Written { frame: 1, count: 1 };
            }
        };
        let other = Arc::clone(&shared);
        let other = thread::spawn(move || careless(&other));
        careless(&shared);
        other.join().unwrap();
    });
}
