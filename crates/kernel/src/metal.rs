//! Named metals: complex indices of refraction at the wavelengths that stand for red, green and blue.
//!
//! η and k at 630, 532 and 465 nm, interpolated linearly in the tables of the LUXPOP database, which holds silver, copper and
//! gold (Palik 1985) and aluminium. Three wavelengths instead of an integral over the spectrum: that is what an RGB renderer
//! can say about a metal, and it is good to a few per cent of the colour.

use crate::rgb::Rgb;

crate::choice! {
    /// A metal whose index is known.
    pub enum Metal {
        /// Ag
        Silver = "silver",
        /// Al
        Aluminium = "aluminium",
        /// Au
        Gold = "gold",
        /// Cu
        Copper = "copper",
    }
}

impl Metal {
    /// η and k at red, green and blue.
    pub const fn index(self) -> [Rgb<f64>; 2] {
        match self {
            Self::Silver => [Rgb::new(0.1342, 0.1297, 0.1395), Rgb::new(3.9628, 3.1942, 2.6135)],
            Self::Aluminium => [Rgb::new(1.3571, 0.8843, 0.6605), Rgb::new(7.5878, 6.4700, 5.6536)],
            Self::Gold => [Rgb::new(0.1837, 0.4573, 1.3724), Rgb::new(3.0663, 2.4084, 1.8250)],
            Self::Copper => [Rgb::new(0.2459, 1.0723, 1.1569), Rgb::new(3.3784, 2.5907, 2.4572)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fresnel::Fresnel;
    use crate::model::Choice;

    #[test]
    fn gold_is_yellow_copper_red_and_silver_white() {
        let straight = |metal: Metal| Fresnel::<f64>::from(metal).reflectance(1.0);
        let (gold, copper, silver) = (straight(Metal::Gold), straight(Metal::Copper), straight(Metal::Silver));
        assert!(gold.r > 0.9 && gold.g > 0.7 && gold.b < 0.5, "{gold:?}");
        assert!(copper.r > 0.9 && copper.g < 0.7 && copper.b < 0.65, "{copper:?}");
        assert!(silver.r > 0.95 && silver.b > 0.9, "{silver:?}");
        assert_eq!(Metal::named("gold"), Some(Metal::Gold));
        assert_eq!(Metal::named("gould"), None);
    }
}
