//! A finished figure, and its conversion to SVG and PNG.

use kuva::RasterBackend;
use kuva::backend::svg::SvgBackend;
use kuva::render::render::Scene;

/// Pixels of a PNG per pixel of the SVG.
const PNG_SCALE: f32 = 2.0;

/// A finished figure.
#[derive(Debug)]
pub struct Picture {
    pub(super) scene: Scene,
}

/// Why a figure cannot be rasterised.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("can't draw the picture: {0}")]
pub struct PictureError(String);

impl Picture {
    /// As SVG text.
    pub fn svg(&self) -> String {
        // Without a view box, an embedding page can crop the figure but not scale it.
        let view_box = format!("<svg viewBox=\"0 0 {} {}\" ", self.scene.width, self.scene.height);
        SvgBackend::new().render_scene(&self.scene).replacen("<svg ", &view_box, 1)
    }

    /// As a PNG file's bytes, twice the SVG's size.
    ///
    /// # Errors
    /// The encoder fails.
    pub fn png(&self) -> Result<Vec<u8>, PictureError> {
        RasterBackend::new().with_scale(PNG_SCALE).render_scene(&self.scene).map_err(PictureError)
    }
}
