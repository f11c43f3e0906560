//! Analytic reflectance models, all in sr⁻¹ and 0 unless both directions are above the surface.

mod ashikhmin_shirley;
mod blinn_phong;
mod cook_torrance;
mod ggx;
mod ggx_lobes;
mod lafortune;
mod lambert;
mod plastic;
mod ward;

pub use ashikhmin_shirley::AshikhminShirley;
pub use blinn_phong::BlinnPhong;
pub use cook_torrance::CookTorrance;
pub use ggx::Ggx;
pub use ggx_lobes::{GgxLobe, GgxLobes};
pub use lafortune::{Lafortune, LafortuneLobe};
pub use lambert::Lambert;
pub use plastic::Plastic;
pub use ward::Ward;

use brdf_param::DirectionPair;

use crate::brdf::is_lit;
use crate::{Brdf, Rgb};

/// Any of the analytic models, as one type.
///
/// ```
/// use brdf_model::{Analytic, Brdf, Lambert, Rgb};
/// use brdf_param::DirectionPair;
///
/// let paper = Analytic::Lambert(Lambert { albedo: Rgb::splat(0.8) });
/// let value = paper.eval(&DirectionPair::from_angles(0.3, 0.0, 0.6, 2.0));
/// assert!((value.g - 0.8 / std::f64::consts::PI).abs() < 1e-12);
/// let below = paper.eval(&DirectionPair::from_angles(0.3, 0.0, 2.0, 2.0));
/// assert_eq!(below, Rgb::BLACK);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Analytic {
    /// An ideal diffuser: [`Lambert`].
    Lambert(Lambert),
    /// Generalized cosine lobes: [`Lafortune`].
    Lafortune(Lafortune),
    /// Microfacets with V-groove shadowing: [`CookTorrance`].
    CookTorrance(CookTorrance),
    /// An anisotropic Phong lobe: [`AshikhminShirley`].
    AshikhminShirley(AshikhminShirley),
    /// A diffuse base with a normalized Blinn lobe: [`Plastic`].
    Plastic(Plastic),
    /// Blinn's shading formula: [`BlinnPhong`].
    BlinnPhong(BlinnPhong),
    /// An anisotropic Gaussian lobe: [`Ward`].
    Ward(Ward),
    /// Microfacets with the GGX distribution: [`Ggx`].
    Ggx(Ggx),
}

impl Brdf for Analytic {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        if !is_lit(pair) {
            return Rgb::BLACK;
        }
        match self {
            Self::Lambert(model) => model.value(),
            Self::Lafortune(model) => model.value(pair),
            Self::CookTorrance(model) => model.value(pair),
            Self::AshikhminShirley(model) => model.value(pair),
            Self::Plastic(model) => model.value(pair),
            Self::BlinnPhong(model) => model.value(pair),
            Self::Ward(model) => model.value(pair),
            Self::Ggx(model) => model.value(pair),
        }
    }
}
