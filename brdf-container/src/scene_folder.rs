//! Folders of scenes to paint: made, and opened again with their paintings.

use std::path::{Path, PathBuf};

use brdf_files::{FileError, MappedFile, OutputFolder};
use brdf_image::encode_png;
use brdf_io::ReadOptions;
use brdf_job::Job;
use brdf_mesh::Mesh;
use brdf_paint::{
    GroundTruth, PaintError, PaintErrors, PaintView, PaintedImage, PaintedMaterial, PictureInfo,
    PreparedView, SetupReport, TruthRecord, ViewBuffers, prepare, truth_errors,
};

use crate::error::ContainerError;
use crate::mesh_file::open_mesh;
use crate::open::{MaterialFile, OpenError};
use crate::scene::{
    PaintScene, read_buffers, read_painting, read_scene, write_buffers, write_painting, write_scene,
};

/// A scene that cannot be made or used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A file that cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A material that paintings show.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// A part that cannot be encoded.
    #[error(transparent)]
    Content(#[from] ContainerError),
    /// Views that cannot be painted, or work that was stopped.
    #[error(transparent)]
    Paint(#[from] PaintError),
    /// Texture coordinates that repeat a tile.
    #[error(
        "{mesh}: texture coordinates outside [0, 1] repeat a tile, but each place is painted for itself"
    )]
    Tiled {
        /// The mesh.
        mesh: String,
    },
    /// A view that the scene has not.
    #[error("{name}: no such view; the scene has {}", views.join(", "))]
    NoView {
        /// What was asked for.
        name: String,
        /// Names of the views.
        views: Vec<String>,
    },
    /// Two paintings of one view: which is meant is not known.
    #[error("{} and {}: two paintings of one view; remove one", first.display(), second.display())]
    Doubled {
        /// One of them.
        first: PathBuf,
        /// The other.
        second: PathBuf,
    },
    /// No painting.
    #[error("{}: no painting; save them as {example}.png and so on, over the guides beside it", folder.display())]
    NothingPainted {
        /// The folder where paintings belong.
        folder: PathBuf,
        /// Name of a view.
        example: String,
    },
}

/// What a scene is made of.
#[derive(Debug)]
pub struct SceneSetup<'a> {
    /// The object.
    pub mesh: &'a Mesh,
    /// What the mesh is called in `scene.toml`, by which it is opened again.
    pub mesh_name: String,
    /// Cameras and lights.
    pub views: Vec<PaintView>,
    /// Columns and rows of the pictures.
    pub size: [usize; 2],
    /// Materials of which paintings are rendered, blended over the surface, if they are not painted.
    pub truth: Option<[String; 3]>,
}

impl SceneSetup<'_> {
    /// Fills a folder: `scene.toml`, `guides/` to paint over, `buffers/`, and `painted/` for the paintings. Paintings that
    /// stand in its place stay, unless others are rendered.
    ///
    /// # Errors
    ///
    /// [`SceneError::Tiled`]; [`SceneError::Paint`] for a view that does not show the object and for work that was
    /// stopped; [`SceneError::Open`] for the materials; [`SceneError::File`].
    pub fn write(
        self,
        folder: &mut OutputFolder,
        version: &str,
        job: &Job<'_>,
    ) -> Result<SetupReport, SceneError> {
        let Self { mesh, mesh_name, views, size, truth } = self;
        if !mesh.lies_on_one_tile() {
            return Err(SceneError::Tiled { mesh: mesh_name });
        }
        views.iter().try_for_each(|view| view.check(mesh))?;
        let files = truth.as_ref().map(open_truth).transpose()?;
        let (guides, exact) = (folder.create_folder("guides")?, folder.create_folder("buffers")?);
        let has_room = files.is_some() || !folder.place().join("painted").exists();
        let painted = has_room.then(|| folder.create_folder("painted")).transpose()?;
        let write = |folder: &Path, name: String, bytes: Vec<u8>| {
            let path = folder.join(name);
            std::fs::write(&path, bytes).map_err(FileError::file(&path, "writing"))
        };
        let mut take = |view: PreparedView| -> Result<(), SceneError> {
            let guide = encode_png(&view.guide).map_err(ContainerError::from)?;
            write(&guides, format!("{}.png", view.name), guide)?;
            write(&exact, format!("{}.exr", view.name), write_buffers(&view.buffers)?)?;
            if let (Some(image), Some(painted)) = (&view.painting, &painted) {
                write(painted, format!("{}.exr", view.name), write_painting(image)?)?;
            }
            Ok(())
        };
        let blended = files.as_ref().map(blend);
        let prepared = prepare(mesh, &views, size, blended, job, &mut take)?;
        let truth = truth.zip(prepared.scale);
        let truth = truth.map(|(materials, scale)| TruthRecord { materials, scale });
        let scene = PaintScene { mesh: mesh_name, uv: mesh.uv_source(), size, views, truth };
        folder.write("scene.toml", write_scene(&scene)?.as_bytes())?;
        Ok(SetupReport {
            brdf: version.to_owned(),
            scene: folder.place().to_string_lossy().into_owned(),
            views: scene.views.len(),
            size,
            pixels: prepared.pixels,
            lit_pixels: prepared.lit_pixels,
            uv: scene.uv,
            truth: scene.truth,
        })
    }
}

fn open_truth(names: &[String; 3]) -> Result<[MaterialFile; 3], OpenError> {
    let [a, b, c] = names.each_ref().map(|name| MaterialFile::open(name, &ReadOptions::default()));
    Ok([a?, b?, c?])
}

/// The blend of three materials, unscaled.
fn blend(files: &[MaterialFile; 3]) -> GroundTruth<'_> {
    GroundTruth { brdfs: files.each_ref().map(MaterialFile::brdf), scale: 1.0 }
}

/// The painting of a view: its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Painting {
    /// Which of the scene's views.
    pub view: usize,
    /// Where the picture is.
    pub picture: PathBuf,
}

/// A folder with a scene, its buffers and its paintings.
#[derive(Clone, Debug)]
pub struct SceneFolder {
    root: PathBuf,
    /// What `scene.toml` says.
    pub scene: PaintScene,
}

/// The paintings of a folder, and what is not one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Paintings {
    /// One for each view that has a painting, in the order of the views.
    pub painted: Vec<Painting>,
    /// Names of views without one.
    pub missing: Vec<String>,
    /// Files of no view.
    pub strange: Vec<PathBuf>,
}

impl SceneFolder {
    /// Opens a folder.
    ///
    /// # Errors
    ///
    /// [`FileError`]; its content as of [`read_scene`].
    pub fn open(root: &Path) -> Result<Self, FileError> {
        let path = root.join("scene.toml");
        let text = std::fs::read_to_string(&path).map_err(FileError::file(&path, "reading"))?;
        let scene = read_scene(&text).map_err(FileError::content(&path))?;
        Ok(Self { root: root.to_owned(), scene })
    }

    /// Returns the folder of the paintings.
    pub fn painted(&self) -> PathBuf {
        self.root.join("painted")
    }

    /// Returns the paintings that are there: files named as views, PNG, JPEG or EXR.
    ///
    /// # Errors
    ///
    /// [`SceneError::NothingPainted`]; [`SceneError::Doubled`]; [`SceneError::File`] for a folder that cannot be read.
    pub fn paintings(&self) -> Result<Paintings, SceneError> {
        let pictures = files_in(&self.painted())?;
        let mut found = Paintings::default();
        for (index, view) in self.scene.views.iter().enumerate() {
            let own: Vec<&PathBuf> =
                pictures.iter().filter(|path| is_of(path, &view.name)).collect();
            match &own[..] {
                [] => found.missing.push(view.name.clone()),
                [picture] => {
                    found.painted.push(Painting { view: index, picture: (*picture).clone() });
                }
                [first, second, ..] => {
                    let [first, second] = [first, second].map(|path| (*path).clone());
                    return Err(SceneError::Doubled { first, second });
                }
            }
        }
        let views = &self.scene.views;
        found.strange = pictures
            .iter()
            .filter(|path| !views.iter().any(|view| is_of(path, &view.name)))
            .cloned()
            .collect();
        match found.missing.first() {
            Some(example) if found.painted.is_empty() => {
                Err(SceneError::NothingPainted { folder: self.painted(), example: example.clone() })
            }
            _ => Ok(found),
        }
    }

    /// Returns what there is to know of paintings before they are learned from; views of these names are held out.
    ///
    /// # Errors
    ///
    /// [`SceneError::NoView`] for a name that no view has.
    pub fn infos(
        &self,
        paintings: &[Painting],
        held_out: &[String],
    ) -> Result<Vec<PictureInfo>, SceneError> {
        let views = &self.scene.views;
        if let Some(name) = held_out.iter().find(|name| !views.iter().any(|v| v.name == **name)) {
            let views = views.iter().map(|view| view.name.clone()).collect();
            return Err(SceneError::NoView { name: name.clone(), views });
        }
        let info = |painting: &Painting| {
            let view = &self.scene.views[painting.view];
            let is_exr =
                painting.picture.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
            PictureInfo {
                name: view.name.clone(),
                white: view.white,
                may_be_saturated: view.has_shadows && !is_exr,
                is_held_out: held_out.contains(&view.name),
            }
        };
        Ok(paintings.iter().map(info).collect())
    }

    /// Returns a painting and the buffers of its view, white as the view says.
    ///
    /// # Errors
    ///
    /// [`FileError`].
    pub fn load(&self, painting: &Painting) -> Result<(ViewBuffers, PaintedImage), FileError> {
        let view = &self.scene.views[painting.view];
        let path = self.root.join("buffers").join(format!("{}.exr", view.name));
        let buffers = read_buffers(&MappedFile::open(&path)?, self.scene.size)
            .map_err(FileError::content(&path))?;
        let image = read_painting(&MappedFile::open(&painting.picture)?)
            .map_err(FileError::content(&painting.picture))?;
        Ok((buffers, image.balanced(view.white)))
    }

    /// Returns the errors of a material over views and lights between those of the scene, or `None` where nobody knows
    /// what was painted.
    ///
    /// # Errors
    ///
    /// [`SceneError`] if the mesh or a material that the paintings show is gone.
    pub fn truth_errors(
        &self,
        material: &PaintedMaterial,
        least_cosine: f64,
    ) -> Result<Option<PaintErrors>, SceneError> {
        let Some(record) = &self.scene.truth else { return Ok(None) };
        let (mesh, _) = open_mesh(Path::new(&self.scene.mesh), Some(self.scene.uv))?;
        let files = open_truth(&record.materials)?;
        let truth = GroundTruth { scale: record.scale, ..blend(&files) };
        Ok(Some(truth_errors(&truth, &mesh, self.scene.size, least_cosine, material)?))
    }
}

/// Files of a folder, in order; none if it is not there.
fn files_in(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let refused = || FileError::file(folder, "looking into");
    let entries = std::fs::read_dir(folder).map_err(refused())?;
    let mut paths: Vec<PathBuf> =
        entries.map(|entry| entry.map(|e| e.path())).collect::<Result<_, _>>().map_err(refused())?;
    paths.retain(|path| path.is_file());
    paths.sort();
    Ok(paths)
}

/// Whether a file is the painting of a view.
fn is_of(path: &Path, view: &str) -> bool {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let is_picture = ending.is_some_and(|e| ["png", "jpg", "jpeg", "exr"].contains(&e.as_str()));
    is_picture && path.file_stem().is_some_and(|stem| stem == view)
}
