//! Positions of the four bodies, and their joints.
//!
//! Ground axes: origin at the rear contact, x along the rear wheel's heading, y right, z down.

use motion::bicycle::{ForcePoint, Parameters};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Indices in [`Bicycle::bodies`].
pub(super) const REAR_WHEEL: usize = 0;
pub(super) const REAR_FRAME: usize = 1;
pub(super) const FRONT_FRAME: usize = 2;
pub(super) const FRONT_WHEEL: usize = 3;

/// A rigid body in ground axes.
pub(super) struct Body {
    pub(super) mass: f64,
    /// Centre of mass \[m\].
    pub(super) centre: Vector3<f64>,
    /// Inertia about the centre of mass, ground axes \[kg m^2\].
    pub(super) inertia: Matrix3<f64>,
}

/// A hinge: two bodies share a point and an axis.
pub(super) struct Hinge {
    pub(super) parent: usize,
    pub(super) child: usize,
    pub(super) point: Vector3<f64>,
    pub(super) axis: Vector3<f64>,
}

/// A wheel's lowest point, which rolls on the ground without slip.
pub(super) struct Contact {
    pub(super) wheel: usize,
    pub(super) axle: Vector3<f64>,
    pub(super) radius: f64,
}

impl Contact {
    /// From the wheel's centre to its lowest point.
    pub(super) fn arm(&self) -> Vector3<f64> {
        (Vector3::z() - self.axle * self.axle.z).normalize() * self.radius
    }

    /// Rate of that arm when the wheel turns at `omega`: the contact moves along the rim.
    pub(super) fn arm_rate(&self, omega: &Vector3<f64>) -> Vector3<f64> {
        let axle_rate = omega.cross(&self.axle);
        let d = Vector3::z() - self.axle * self.axle.z;
        let d_rate = -(self.axle * axle_rate.z + axle_rate * self.axle.z);
        let length = d.norm();
        (d_rate / length - d * (d.dot(&d_rate) / length.powi(3))) * self.radius
    }
}

/// The bicycle in one configuration.
pub(super) struct Bicycle {
    /// Pitch from the upright bicycle's \[rad\].
    pub(super) pitch: f64,
    pub(super) bodies: [Body; 4],
    /// Rear axle, head, front axle.
    pub(super) hinges: [Hinge; 3],
    /// Rear, front.
    pub(super) contacts: [Contact; 2],
    /// From the upright rear frame to its attitude.
    rear: Rotation3<f64>,
}

impl Bicycle {
    /// From the rear frame's centre of mass to a point of it.
    pub(super) fn arm_on_rear_frame(&self, p: &Parameters, point: ForcePoint) -> Vector3<f64> {
        self.rear * Vector3::new(point.ahead_m - p.xB, 0.0, -point.height_m - p.zB)
    }

    /// With both wheels on the ground; `None` if no pitch below 80 degrees brings them there.
    pub(super) fn on_ground(p: &Parameters, roll: f64, steer: f64) -> Option<Self> {
        let depth = |pitch: f64| Self::placed(p, roll, steer, pitch).front_depth();
        let (mut low, mut high) = (-1.4, 1.4);
        if !(depth(low) > 0.0 && depth(high) < 0.0) {
            return None;
        }
        // Bisection to the last bit.
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return Some(Self::placed(p, roll, steer, middle));
            }
            if depth(middle) > 0.0 { low = middle } else { high = middle }
        }
    }

    /// Depth of the front wheel's lowest point below the ground \[m\].
    fn front_depth(&self) -> f64 {
        (self.bodies[FRONT_WHEEL].centre + self.contacts[1].arm()).z
    }

    /// With the rear wheel on the ground.
    fn placed(p: &Parameters, roll: f64, steer: f64, pitch: f64) -> Self {
        let rear = Rotation3::from_axis_angle(&Vector3::x_axis(), roll)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), pitch);
        let steer_axis = Unit::new_normalize(Vector3::new(p.lam.sin(), 0.0, p.lam.cos()));
        let front = rear * Rotation3::from_axis_angle(&steer_axis, steer);

        let rear_contact = Contact { wheel: REAR_WHEEL, axle: rear * Vector3::y(), radius: p.rR };
        let front_contact = Contact { wheel: FRONT_WHEEL, axle: front * Vector3::y(), radius: p.rF };

        // A point of the upright bicycle, moved with the rear or the front frame.
        let (hub, head) = (Vector3::new(0.0, 0.0, -p.rR), Vector3::new(p.w + p.c, 0.0, 0.0));
        let with_rear = |x: Vector3<f64>| rear * (x - hub) - rear_contact.arm();
        let with_front = |x: Vector3<f64>| front * (x - head) + with_rear(head);

        let body = |mass: f64, centre: Vector3<f64>, turn: &Rotation3<f64>, i: [f64; 4]| {
            let [xx, yy, zz, xz] = i;
            let own = Matrix3::new(xx, 0.0, xz, 0.0, yy, 0.0, xz, 0.0, zz);
            Body { mass, centre, inertia: turn.matrix() * own * turn.matrix().transpose() }
        };
        let bodies = [
            body(p.mR, with_rear(hub), &rear, [p.IRxx, p.IRyy, p.IRxx, 0.0]),
            body(p.mB, with_rear(Vector3::new(p.xB, 0.0, p.zB)), &rear, [p.IBxx, p.IByy, p.IBzz, p.IBxz]),
            body(p.mH, with_front(Vector3::new(p.xH, 0.0, p.zH)), &front, [p.IHxx, p.IHyy, p.IHzz, p.IHxz]),
            body(p.mF, with_front(Vector3::new(p.w, 0.0, -p.rF)), &front, [p.IFxx, p.IFyy, p.IFxx, 0.0]),
        ];
        let hinges = [
            (REAR_FRAME, REAR_WHEEL, bodies[REAR_WHEEL].centre, rear_contact.axle),
            (REAR_FRAME, FRONT_FRAME, with_rear(head), rear * steer_axis.into_inner()),
            (FRONT_FRAME, FRONT_WHEEL, bodies[FRONT_WHEEL].centre, front_contact.axle),
        ]
        .map(|(parent, child, point, axis)| Hinge { parent, child, point, axis });
        Self { pitch, bodies, hinges, contacts: [rear_contact, front_contact], rear }
    }
}
