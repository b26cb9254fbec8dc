//! Functions of the C language around sparkl2d: particles in, steps with a body force of each particle, particles out.
//! All arrays are of doubles, a row a particle; what the program keeps of them is in its own precision.

use sparkl2d::core::dynamics::models::{CorotatedLinearElasticity, NeoHookeanElasticity};
use sparkl2d::dynamics::solver::{BoundaryHandling, MlsSolver, RigidWorld, SolverParameters};
use sparkl2d::dynamics::{GridNode, GridNodeCgPhase, Particle, ParticleModel, ParticleModelSet, ParticleSet};
use sparkl2d::geometry::SpGrid;
use sparkl2d::math::{Matrix, Point, Real, Vector};
use sparkl2d::rapier::geometry::{ColliderBuilder, ColliderSet};
use std::slice::from_raw_parts;

pub struct World {
    grid: SpGrid<GridNode>,
    phase: SpGrid<GridNodeCgPhase>,
    particles: ParticleSet,
    models: ParticleModelSet,
    walls: ColliderSet,
}

/// World of cells dx wide with its nodes at whole multiples of dx, and an elastic body of E and nu.
///
/// Of each particle: `floats` has x, y, vx, vy, four of the gradient of v, four of F (xx, xy, yx, yy), mass, volume.
#[no_mangle]
pub unsafe extern "C" fn sparkl_new(count: usize, dx: f64, e: f64, nu: f64, floats: *const f64) -> *mut World {
    let mut models = ParticleModelSet::new();
    let model = models.insert(ParticleModel::new(CorotatedLinearElasticity::new(e as Real, nu as Real)));
    let mut particles = ParticleSet::new();
    for row in from_raw_parts(floats, 14 * count).chunks(14) {
        let row: Vec<Real> = row.iter().map(|&value| value as Real).collect();
        let mut one = Particle::new(model, Point::new(row[0], row[1]), dx as Real / 4.0, 1.0);
        one.velocity = Vector::new(row[2], row[3]);
        one.velocity_gradient = Matrix::new(row[4], row[5], row[6], row[7]);
        one.deformation_gradient = Matrix::new(row[8], row[9], row[10], row[11]);
        (one.mass, one.volume0) = (row[12], row[13]);
        particles.insert(one);
    }
    let (grid, phase) = (SpGrid::new(dx as Real).unwrap(), SpGrid::new(dx as Real).unwrap());
    Box::into_raw(Box::new(World { grid, phase, particles, models, walls: ColliderSet::new() }))
}

/// Let the nodes inside a box stick.
#[no_mangle]
pub unsafe extern "C" fn sparkl_wall(world: *mut World, x: f64, y: f64, half_x: f64, half_y: f64) {
    let centre = Vector::new(x as Real, y as Real);
    (*world).walls.insert(ColliderBuilder::cuboid(half_x as Real, half_y as Real).translation(centre).build());
}

/// Take one step with the body force b of each particle, which adds b dt to its velocity before the transfer to nodes.
/// Return the step that the program took, which it bounds by the speed of sound.
#[no_mangle]
pub unsafe extern "C" fn sparkl_step(world: *mut World, dt: f64, b: *const f64) -> f64 {
    let (world, dt) = (&mut *world, dt as Real);
    let b = from_raw_parts(b, 2 * world.particles.len());
    for (one, b) in world.particles.particles_mut().iter_mut().zip(b.chunks(2)) {
        one.velocity += Vector::new(b[0] as Real, b[1] as Real) * dt;
    }
    let parameters = SolverParameters {
        dt,
        boundary_handling: BoundaryHandling::Stick,
        stop_after_one_substep: true,
        ..SolverParameters::default()
    };
    let rigid = RigidWorld { colliders: &world.walls };
    let (grid, phase, none) = (&mut world.grid, &mut world.phase, Vector::zeros());
    MlsSolver::step(&parameters, &none, &rigid, grid, phase, &mut world.particles, &world.models, &mut ()) as f64
}

/// Write x, y, vx, vy, four of F and whether the program gave a particle up.
#[no_mangle]
pub unsafe extern "C" fn sparkl_read(world: *const World, floats: *mut f64) {
    for (k, one) in (*world).particles.iter().enumerate() {
        let (x, v, f) = (one.position, one.velocity, one.deformation_gradient);
        let row = [x.x, x.y, v.x, v.y, f[(0, 0)], f[(0, 1)], f[(1, 0)], f[(1, 1)], one.failed as u8 as Real];
        for (c, value) in row.iter().enumerate() {
            *floats.add(9 * k + c) = *value as f64;
        }
    }
}

/// Write the Kirchhoff stress (xx, xy, yx, yy) of F in one of two models, of an undamaged particle.
#[no_mangle]
pub unsafe extern "C" fn sparkl_stress(neo_hookean: i32, e: f64, nu: f64, f: *const f64, floats: *mut f64) {
    let f: Vec<Real> = from_raw_parts(f, 4).iter().map(|&value| value as Real).collect();
    let f = Matrix::new(f[0], f[1], f[2], f[3]);
    let found = if neo_hookean != 0 {
        NeoHookeanElasticity::new(e as Real, nu as Real).kirchhoff_stress(1.0, 1.0, &f)
    } else {
        CorotatedLinearElasticity::new(e as Real, nu as Real).kirchhoff_stress(1.0, 1.0, &f)
    };
    for (k, value) in [found[(0, 0)], found[(0, 1)], found[(1, 0)], found[(1, 1)]].iter().enumerate() {
        *floats.add(k) = *value as f64;
    }
}
