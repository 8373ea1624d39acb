//! Documents put together from JSON and a buffer.

use base64::Engine;
use rayflock_scene::Scene;
use serde_json::{Value, json};

use crate::ImportError;
use crate::tests::load_bytes;

type Loaded = Result<(Scene, Vec<String>), ImportError>;

/// A document under construction; each column gets its own buffer view and accessor.
pub(super) struct Document {
    pub(super) json: Value,
    pub(super) buffer: Vec<u8>,
}

impl Document {
    /// Without anything in it.
    pub(super) fn new() -> Self {
        let json = json!({
            "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }],
            "nodes": [{ "mesh": 0 }], "meshes": [], "accessors": [], "bufferViews": [],
        });
        Self { json, buffer: Vec::new() }
    }

    /// With one triangle: accessor 0 holds its positions.
    pub(super) fn triangle() -> Self {
        let mut document = Self::new();
        document.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        document.json["accessors"][0]["min"] = json!([0, 0, 0]);
        document.json["accessors"][0]["max"] = json!([1, 1, 0]);
        document.json["meshes"] = json!([{
            "name": "body", "primitives": [{ "attributes": { "POSITION": 0 } }],
        }]);
        document
    }

    /// Adds an accessor and gives its index.
    pub(super) fn column(
        &mut self,
        kind: &str,
        component: u32,
        count: usize,
        bytes: &[u8],
    ) -> usize {
        let view =
            json!({ "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len() });
        self.buffer.extend(bytes);
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(view);
        let view = views.len() - 1;
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(json!({
            "bufferView": view, "componentType": component, "count": count, "type": kind,
        }));
        accessors.len() - 1
    }

    pub(super) fn floats(&mut self, kind: &str, count: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.column(kind, 5126, count, &bytes)
    }

    pub(super) fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    pub(super) fn material(mut self, material: &Value) -> Self {
        self.json["materials"] = json!([material]);
        self.primitive()["material"] = json!(0);
        self
    }

    /// The document with its buffer inside.
    pub(super) fn text(&self) -> String {
        let mut json = self.json.clone();
        if json.get("buffers").is_none() {
            let data = base64::engine::general_purpose::STANDARD.encode(&self.buffer);
            let uri = format!("data:application/octet-stream;base64,{data}");
            json["buffers"] = json!([{ "byteLength": self.buffer.len(), "uri": uri }]);
        }
        json.to_string()
    }

    pub(super) fn load(&self) -> Loaded {
        load_bytes("a.gltf", self.text().as_bytes())
    }

    /// Loads what must not load; gives the message.
    pub(super) fn message(&self) -> String {
        self.load().unwrap_err().to_string()
    }

    pub(super) fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.buffer.len() }]);
        let mut json = json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut bytes = b"glTF\x02\0\0\0".to_vec();
        bytes.extend((28 + json.len() as u32 + self.buffer.len() as u32).to_le_bytes());
        bytes.extend((json.len() as u32).to_le_bytes());
        bytes.extend(b"JSON");
        bytes.extend(json);
        bytes.extend((self.buffer.len() as u32).to_le_bytes());
        bytes.extend(b"BIN\0");
        bytes.extend(&self.buffer);
        bytes
    }
}

/// Fails when a message lacks a part.
pub(super) fn assert_has(message: &str, parts: &[&str]) {
    assert!(parts.iter().all(|part| message.contains(part)), "{message}\nlacks one of {parts:?}");
}
