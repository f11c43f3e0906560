//! Results computed elsewhere, with their origin in each module.

mod eigenvalues;
mod merl_layout;
mod microfacet;
mod rgl;
