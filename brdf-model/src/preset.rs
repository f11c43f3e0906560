//! Built-in materials with published parameters.
//!
//! Lafortune coefficients: Lafortune, Foo, Torrance and Greenberg 1997. Ashikhmin–Shirley: Wang,
//! Tran and Luebke 2004. The other parameters are the project's own; the papers give none.

use crate::analytic::{
    Analytic, AshikhminShirley, BlinnPhong, CookTorrance, Ggx, Lafortune, LafortuneLobe, Lambert,
    Plastic, Ward,
};
use crate::{Fresnel, Rgb};

/// A named material: an analytic model with published or chosen parameters.
///
/// ```
/// use brdf_model::{Brdf, Preset};
/// use brdf_param::DirectionPair;
///
/// let gold = Preset::find("ggx").expect("a preset of this crate");
/// assert_eq!(gold.description(), "gold, roughness 0.25");
/// let value = gold.brdf().eval(&DirectionPair::from_angles(0.3, 0.0, 0.3, std::f64::consts::PI));
/// assert!(value.r > value.b);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    name: &'static str,
    description: &'static str,
    build: fn() -> Analytic,
}

impl Preset {
    /// All presets, the default material first.
    pub const ALL: [Self; 13] = [
        Self::new(
            "lafortune-blue-paint",
            "blue paint: retro-reflective and off-specular lobes",
            lafortune_blue_paint,
        ),
        Self::new("lafortune-clay", "clay: broad forward lobes", lafortune_clay),
        Self::new("lafortune-skin", "human skin", lafortune_skin),
        Self::new("lafortune-felt", "grey felt", lafortune_felt),
        Self::new("cook-torrance", "grey, one glossy lobe that grows at grazing", cook_torrance),
        Self::new(
            "ashikhmin-shirley",
            "anisotropic metal with exponents 10 and 100",
            ashikhmin_shirley,
        ),
        Self::new("plastic", "grey plastic", || plastic(Rgb::splat(0.3), 0.5, 40.0)),
        Self::new("red-plastic", "red plastic", || plastic(Rgb::new(0.5, 0.03, 0.03), 0.4, 40.0)),
        Self::new("light-brown-plastic", "light brown plastic", || {
            plastic(Rgb::new(0.46, 0.30, 0.17), 0.25, 60.0)
        }),
        Self::new("blinn-phong", "diffuse grey with a plain cosine lobe", blinn_phong),
        Self::new("lambert", "ideal grey diffuser, albedo 0.5", || {
            Analytic::Lambert(Lambert { albedo: Rgb::splat(0.5) })
        }),
        Self::new("ward", "anisotropic brushed metal, slopes 0.1 and 0.3", ward),
        Self::new("ggx", "gold, roughness 0.25", ggx),
    ];

    const fn new(name: &'static str, description: &'static str, build: fn() -> Analytic) -> Self {
        Self { name, description, build }
    }

    /// Returns the preset of this name, or `None` where there is none.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name == name)
    }

    /// Returns the name of the preset, as it is written after `preset:` on the command line.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Returns one line about the material.
    pub fn description(&self) -> &'static str {
        self.description
    }

    /// Returns the model of the material.
    pub fn brdf(&self) -> Analytic {
        (self.build)()
    }
}

fn lafortune(diffuse: [f64; 3], lobes: &[[[f64; 3]; 3]]) -> Analytic {
    let lobes = lobes
        .iter()
        .map(|&[cxy, cz, n]| LafortuneLobe { cxy: cxy.into(), cz: cz.into(), n: n.into() })
        .collect();
    Analytic::Lafortune(Lafortune { diffuse: diffuse.into(), lobes })
}

fn lafortune_blue_paint() -> Analytic {
    lafortune(
        [0.3094, 0.39667, 0.70837],
        &[
            [
                [0.870567, 0.857255, 0.670982],
                [0.803624, 0.774290, 0.586674],
                [21.820103, 18.597755, 7.472717],
            ],
            [
                [-0.451218, -0.406681, -0.477976],
                [0.023123, 0.017625, 0.227295],
                [2.774499, 2.581499, 3.677653],
            ],
            [
                [-1.031545, -1.029426, -1.026588],
                [0.706734, 0.696530, 0.687715],
                [66.899060, 63.767912, 57.489181],
            ],
        ],
    )
}

fn lafortune_clay() -> Analytic {
    lafortune(
        [0.383626, 0.260749, 0.274207],
        &[
            [
                [-1.089701, -1.102701, -1.107603],
                [-1.354682, -2.714801, -1.569866],
                [17.968505, 11.024489, 21.270282],
            ],
            [
                [-0.733381, -0.793320, -0.848206],
                [0.676108, 0.679314, 0.726031],
                [8.219745, 9.055139, 11.261951],
            ],
            [
                [-1.010548, -1.012378, -1.011263],
                [0.910783, 0.885239, 0.892451],
                [152.912795, 141.937171, 201.046802],
            ],
        ],
    )
}

fn lafortune_skin() -> Analytic {
    lafortune(
        [0.428425, 0.301341, 0.331054],
        &[
            [
                [-1.131747, -1.016939, -0.966018],
                [-1.209182, -1.462488, -1.222419],
                [6.421658, 3.699932, 3.524889],
            ],
            [
                [-0.546570, -0.643533, -0.638934],
                [0.380123, 0.410559, 0.437367],
                [3.685044, 4.266495, 4.539742],
            ],
            [
                [-0.998888, -1.020153, -1.027479],
                [0.857998, 0.703913, 0.573625],
                [64.208486, 63.919687, 43.809866],
            ],
        ],
    )
}

fn lafortune_felt() -> Analytic {
    let grey = |v: f64| [v; 3];
    lafortune(
        grey(0.025865),
        &[
            [grey(-0.304075), grey(-0.065992), grey(3.047892)],
            [grey(-0.749561), grey(-1.167929), grey(6.931827)],
            [grey(1.004921), grey(-0.205529), grey(94.117332)],
        ],
    )
}

fn cook_torrance() -> Analytic {
    Analytic::CookTorrance(CookTorrance { diffuse: Rgb::splat(0.3), ior: 2.6, slope: 0.25 })
}

fn ashikhmin_shirley() -> Analytic {
    Analytic::AshikhminShirley(AshikhminShirley {
        diffuse: Rgb::splat(0.5),
        specular: Rgb::splat(0.75),
        nu: 10.0,
        nv: 100.0,
    })
}

fn plastic(diffuse: Rgb, specular: f64, n: f64) -> Analytic {
    Analytic::Plastic(Plastic { diffuse, specular, n })
}

fn blinn_phong() -> Analytic {
    Analytic::BlinnPhong(BlinnPhong {
        diffuse: Rgb::splat(0.1),
        specular: Rgb::splat(0.5),
        n: 20.0,
    })
}

fn ward() -> Analytic {
    Analytic::Ward(Ward {
        diffuse: Rgb::splat(0.1),
        specular: Rgb::splat(0.3),
        alpha_x: 0.1,
        alpha_y: 0.3,
    })
}

fn ggx() -> Analytic {
    Analytic::Ggx(Ggx {
        diffuse: Rgb::BLACK,
        fresnel: Fresnel::Conductor {
            eta: Rgb::new(0.143, 0.375, 1.442),
            k: Rgb::new(3.983, 2.386, 1.603),
        },
        alpha_x: 0.25,
        alpha_y: 0.25,
    })
}
