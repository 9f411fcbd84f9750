//! Opacity filters: what they are asked, and what becomes of their answers.

use super::{all, blocked, ordinary_rays, telling_rays};
use crate::support::{Random, crowd, geometry, soup, sphere};
use gonio_accel::{Accel, Brute, Hit, Intersect, Obvhs, Opacity, Ray8};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;

#[test]
fn an_opacity_filter_lets_light_through_chosen_triangles() {
    struct Only(u32);
    impl Opacity for Only {
        fn blocks(&self, ray: usize, hit: &Hit) -> bool {
            assert!(ray < 8 * 100);
            hit.prim % 2 == self.0
        }
    }
    for mesh in [sphere(5, [0.0; 3]), sphere(20, [0.0; 3])] {
        let geometry = geometry(mesh);
        let rays = telling_rays(&geometry, 800, &mut Random(9));
        let (brute, obvhs) = (Brute::new(&geometry), Obvhs::new(&geometry, Intersect::Robust));
        for parity in [0, 1] {
            let expected = blocked(&brute, &rays, Some(&Only(parity)));
            assert_eq!(expected, blocked(&obvhs, &rays, Some(&Only(parity))));
            assert_ne!(expected, blocked(&brute, &rays, None));
        }
    }
}

/// Writes down what it is asked, and lets everything through.
#[derive(Default)]
pub(super) struct Witness(Mutex<Vec<(usize, u32, u32, u32)>>);

impl Opacity for Witness {
    fn blocks(&self, ray: usize, hit: &Hit) -> bool {
        assert!(hit.bary.iter().all(|b| (0.0..=1.000_001).contains(b)) && hit.t >= 0.0);
        self.0.lock().unwrap().push((ray, hit.instance, hit.mesh, hit.prim));
        false
    }
}

impl Witness {
    /// Everything it was asked by a backend, once, in order.
    pub(super) fn of(accel: &dyn Accel, rays: &[Ray8]) -> Vec<(usize, u32, u32, u32)> {
        let witness = Self::default();
        assert!(blocked(accel, rays, Some(&witness)).iter().all(|&bits| bits == 0), "{}", accel.name());
        let mut asked = witness.0.into_inner().unwrap();
        asked.sort_unstable();
        asked.dedup();
        asked
    }
}

#[test]
fn a_filter_that_lets_everything_through_is_asked_about_every_triangle_on_the_way() {
    for geometry in [crowd(&mut Random(8)), geometry(soup(300, &mut Random(4))), geometry(sphere(20, [0.0; 3]))] {
        let rays = ordinary_rays(40_000, &mut Random(31));
        let expected = Witness::of(&Brute::new(&geometry), &rays);
        assert!(expected.len() > 1000);
        for accel in all(&geometry) {
            assert_eq!(Witness::of(&*accel, &rays), expected, "{}", accel.name());
        }
    }
}

#[test]
fn a_panic_in_a_filter_comes_out_of_the_backend() {
    struct Panics;
    impl Opacity for Panics {
        fn blocks(&self, _: usize, _: &Hit) -> bool {
            panic!("the filter's own words")
        }
    }
    let geometry = geometry(sphere(20, [0.0; 3]));
    let rays = ordinary_rays(80, &mut Random(1));
    for accel in all(&geometry) {
        let caught = catch_unwind(AssertUnwindSafe(|| blocked(&*accel, &rays, Some(&Panics))));
        let words = *caught.unwrap_err().downcast::<&str>().unwrap();
        assert_eq!(words, "the filter's own words", "{}", accel.name());
    }
}
