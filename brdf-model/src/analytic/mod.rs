//! Analytic reflectance models, all in sr⁻¹ and 0 unless both directions are above the surface.

mod ashikhmin_shirley;
mod blinn_phong;
mod cook_torrance;
mod ggx;
mod lafortune;
mod lambert;
mod plastic;
mod ward;

pub use ashikhmin_shirley::AshikhminShirley;
pub use blinn_phong::BlinnPhong;
pub use cook_torrance::CookTorrance;
pub use ggx::Ggx;
pub use lafortune::{Lafortune, LafortuneLobe};
pub use lambert::Lambert;
pub use plastic::Plastic;
pub use ward::Ward;

use brdf_param::DirectionPair;

use crate::brdf::is_lit;
use crate::{Brdf, Rgb};

/// Any of the analytic models.
#[derive(Clone, Debug, PartialEq)]
pub enum Analytic {
    /// [`Lambert`].
    Lambert(Lambert),
    /// [`Lafortune`].
    Lafortune(Lafortune),
    /// [`CookTorrance`].
    CookTorrance(CookTorrance),
    /// [`AshikhminShirley`].
    AshikhminShirley(AshikhminShirley),
    /// [`Plastic`].
    Plastic(Plastic),
    /// [`BlinnPhong`].
    BlinnPhong(BlinnPhong),
    /// [`Ward`].
    Ward(Ward),
    /// [`Ggx`].
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
