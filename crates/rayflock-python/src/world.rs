//! What a scene holds: objects, and engines with the frame that each knows.
//!
//! Changes are noted only; the engine that is asked next gets the frame as it is then. So many
//! objects can change before anything is done about it, and engines that nobody asks cost nothing.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::time::Instant;

use rayflock::engine::auto::Choice;
use rayflock::engine::{
    EngineError, EngineKind, Ignored, RayEngine, TraceStats, count_ignored, create,
};
use rayflock::geom::{Aabb, FrameChanges, Geometry, GeometryObject, Mesh, ObjectId};

use crate::errors::Failure;
use crate::pool;
use crate::source::Source;

/// Objects and the engines that know them.
#[derive(Debug)]
pub(crate) struct World {
    /// Answers where a question names no other.
    pub(crate) engine: EngineKind,
    /// Threads where a question names no other number; 0 for one a core.
    pub(crate) threads: usize,
    objects: BTreeMap<u32, WorldObject>,
    next_id: u32,
    /// The objects as engines take them; `None` after a change.
    geometry: Option<Geometry>,
    /// Counts changes.
    version: u64,
    /// The file that moves objects.
    source: Option<Source>,
    members: HashMap<EngineKind, Member>,
    asked_last: Option<EngineKind>,
}

/// An object, and what its owner says about it.
#[derive(Clone, Debug)]
pub(crate) struct WorldObject {
    pub(crate) object: GeometryObject,
    owner: Owner,
}

/// Who may change an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Owner {
    /// Whoever added it.
    Caller,
    /// Nobody: whoever added it said that it stays.
    Nobody,
    /// The file that the scene was loaded from.
    Source,
}

/// An engine and what it knows.
#[derive(Debug)]
pub(crate) struct Member {
    pub(crate) kind: EngineKind,
    pub(crate) engine: Box<dyn RayEngine>,
    geometry: Geometry,
    version: Option<u64>,
    pub(crate) commit_seconds: f64,
    /// What it was asked last.
    pub(crate) asked: Option<Asked>,
}

/// What a question took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked {
    pub(crate) trace: TraceStats,
    pub(crate) seconds: f64,
    /// Who answered, of an engine that chooses.
    pub(crate) choice: Option<Choice>,
}

/// An answer and what it took to find it.
pub(crate) type Traced<T> = Result<(T, TraceStats), EngineError>;

impl World {
    /// Nothing, to be asked by `engine` on so many threads.
    pub(crate) fn new(engine: EngineKind, threads: usize) -> Self {
        Self {
            engine,
            threads,
            objects: BTreeMap::new(),
            next_id: 0,
            geometry: None,
            version: 0,
            source: None,
            members: HashMap::new(),
            asked_last: None,
        }
    }

    /// The same objects, shared until either changes them; no engine knows them yet.
    pub(crate) fn copy(&self) -> Self {
        let (objects, next_id) = (self.objects.clone(), self.next_id);
        let source = self.source.clone();
        Self { objects, next_id, source, ..Self::new(self.engine, self.threads) }
    }

    /// Adds an object and tells its id, which is not used again.
    pub(crate) fn add(&mut self, mesh: Mesh, mask: u32, owner: Owner) -> u32 {
        let id = self.next_id;
        self.next_id = id.saturating_add(1);
        let object = GeometryObject::new(ObjectId(id), mesh).with_mask(mask);
        self.objects.insert(id, WorldObject { object, owner });
        self.change();
        id
    }

    /// The mesh of an object that may change.
    pub(crate) fn mesh_to_change(&self, id: u32) -> Result<Arc<Mesh>, Failure> {
        let found = self.objects.get(&id).ok_or(Failure::UnknownId(id))?;
        if found.owner == Owner::Nobody {
            return Err(Failure::value(format!(
                "object {id} was added with static=True, so it cannot be updated: add it without"
            )));
        }
        found.check_not_of_source()?;
        Ok(Arc::clone(&found.object.shape))
    }

    /// Gives an object another mesh.
    pub(crate) fn replace(&mut self, id: u32, mesh: Mesh) -> Result<(), Failure> {
        let found = self.objects.get_mut(&id).ok_or(Failure::UnknownId(id))?;
        found.object.shape = Arc::new(mesh);
        self.change();
        Ok(())
    }

    /// Takes an object out.
    pub(crate) fn remove(&mut self, id: u32) -> Result<(), Failure> {
        self.objects.get(&id).ok_or(Failure::UnknownId(id))?.check_not_of_source()?;
        self.objects.remove(&id);
        self.change();
        Ok(())
    }

    /// Makes a file the source of objects, of which there must not be any yet.
    pub(crate) fn load(&mut self, source: Source) -> Result<(), Failure> {
        if self.next_id > 0 {
            return Err(Failure::value("a scene is loaded before objects are added"));
        }
        self.next_id = u32::try_from(source.scene().objects.len()).unwrap_or(u32::MAX);
        self.source = Some(source);
        self.take_from_source();
        Ok(())
    }

    /// Moves the objects of the source to a time, in seconds.
    pub(crate) fn evaluate(&mut self, time: f64) -> Result<(), Failure> {
        let Some(source) = &mut self.source else {
            return Err(Failure::value(
                "only scenes that were loaded can be evaluated: rayflock.load reads one",
            ));
        };
        source.evaluate(time)?;
        self.take_from_source();
        Ok(())
    }

    /// Takes over the objects of the source as they are now.
    fn take_from_source(&mut self) {
        let Some(source) = &self.source else { return };
        for object in source.frame().geometry.objects() {
            let (object, owner) = (object.clone(), Owner::Source);
            self.objects.insert(object.id.0, WorldObject { object, owner });
        }
        self.change();
    }

    /// The file that moves objects, if there is one.
    pub(crate) const fn source(&self) -> Option<&Source> {
        self.source.as_ref()
    }

    /// Which camera of the file has this name; without a name its first, `None` where it has none.
    pub(crate) fn camera_idx(&self, name: Option<&str>) -> Result<Option<usize>, Failure> {
        match (&self.source, name) {
            (Some(source), name) => Ok(source.scene().camera_idx(name)?),
            (None, None) => Ok(None),
            (None, Some(name)) => Err(Failure::value(format!(
                "there is no camera \"{name}\": the scene was not loaded, so it has none"
            ))),
        }
    }

    /// The objects that were added, not loaded.
    pub(crate) fn objects_of_callers(&self) -> impl Iterator<Item = &GeometryObject> {
        let added = self.objects.values().filter(|found| found.owner != Owner::Source);
        added.map(|found| &found.object)
    }

    /// The box around everything, over the whole motion of the source.
    pub(crate) fn bounds(&mut self) -> Result<Aabb, Failure> {
        let mut bounds = match &mut self.source {
            Some(source) => source.bounds()?,
            None => Aabb::EMPTY,
        };
        for object in self.objects_of_callers() {
            bounds = bounds.union(&object.bounds());
        }
        Ok(bounds)
    }

    fn change(&mut self) {
        self.geometry = None;
        self.version += 1;
    }

    /// The objects, in the order of their ids.
    pub(crate) fn objects(&self) -> impl Iterator<Item = &WorldObject> {
        self.objects.values()
    }

    /// The objects as engines take them.
    pub(crate) fn geometry(&mut self) -> Result<Geometry, Failure> {
        if let Some(geometry) = &self.geometry {
            return Ok(geometry.clone());
        }
        let objects = self.objects.values().map(|found| found.object.clone());
        let geometry = Geometry::new(objects.collect())?;
        self.geometry = Some(geometry.clone());
        Ok(geometry)
    }

    /// Has an engine that knows the objects as they are answer a question.
    pub(crate) fn ask<T: Send>(
        &mut self,
        kind: Option<EngineKind>,
        threads: Option<usize>,
        question: impl FnOnce(&mut dyn RayEngine, &Geometry) -> Traced<T> + Send,
    ) -> Result<T, Failure> {
        let pool = pool::with_threads(threads.unwrap_or(self.threads))?;
        let (geometry, version) = (self.geometry()?, self.version);
        let member = self.member(kind.unwrap_or(self.engine));
        pool.install(|| {
            member.prepare(&geometry, version)?;
            member.ask(&geometry, question)
        })
    }

    /// The engine that was asked last, if it knows the objects as they are; the scene's own, which
    /// then does, if not.
    pub(crate) fn current_member(&mut self) -> Result<&Member, Failure> {
        let pool = pool::with_threads(self.threads)?;
        let (geometry, version) = (self.geometry()?, self.version);
        let knows = |kind: &EngineKind| {
            self.members.get(kind).is_some_and(|member| member.version == Some(version))
        };
        let kind = self.asked_last.filter(knows).unwrap_or(self.engine);
        let member = self.member(kind);
        pool.install(|| member.prepare(&geometry, version))?;
        Ok(member)
    }

    /// Which primitives no ray hits, because of what they are.
    pub(crate) fn count_ignored(&mut self) -> Result<Ignored, Failure> {
        let pool = pool::with_threads(self.threads)?;
        let geometry = self.geometry()?;
        Ok(pool.install(|| count_ignored(&geometry)))
    }

    fn member(&mut self, kind: EngineKind) -> &mut Member {
        self.asked_last = Some(kind);
        self.members.entry(kind).or_insert_with(|| Member::new(kind))
    }

    /// Forgets what engines know, which may be wrong after one has failed in the middle.
    pub(crate) fn forget_engines(&mut self) {
        self.members.clear();
    }
}

impl WorldObject {
    fn check_not_of_source(&self) -> Result<(), Failure> {
        if self.owner != Owner::Source {
            return Ok(());
        }
        let id = self.object.id.0;
        Err(Failure::value(format!(
            "object {id} belongs to the file that the scene was loaded from: evaluate moves it"
        )))
    }
}

impl Member {
    fn new(kind: EngineKind) -> Self {
        Self {
            kind,
            engine: create(kind),
            geometry: Geometry::default(),
            version: None,
            commit_seconds: 0.0,
            asked: None,
        }
    }

    /// Hands the engine the frame, unless it knows it.
    fn prepare(&mut self, geometry: &Geometry, version: u64) -> Result<(), EngineError> {
        if self.version == Some(version) {
            return Ok(());
        }
        let start = Instant::now();
        let changes = match self.version.take() {
            Some(_) => FrameChanges::between(&self.geometry, geometry),
            None => FrameChanges::all(),
        };
        self.engine.commit(geometry, &changes)?;
        self.commit_seconds = start.elapsed().as_secs_f64();
        self.geometry = geometry.clone();
        self.version = Some(version);
        Ok(())
    }

    fn ask<T>(
        &mut self,
        geometry: &Geometry,
        question: impl FnOnce(&mut dyn RayEngine, &Geometry) -> Traced<T>,
    ) -> Result<T, Failure> {
        let start = Instant::now();
        let (answer, trace) = question(&mut *self.engine, geometry)?;
        let seconds = start.elapsed().as_secs_f64();
        let choice = self.engine.choices().last().copied();
        self.asked = Some(Asked { trace, seconds, choice });
        Ok(answer)
    }
}
