//! x
#![allow(warnings)]
use sim_host::basin::*; use sim_host::ride::*; use sim_host::bicycle::*; use sim_host::num::*;
fn main(){
 let bicycle = catalogue::load("rigid_jason").unwrap();
 let b=Geometry::new(&bicycle.parameters);
 let s=State::upright(&b,Counted(4.0));
 let (m,a)=Operations::of(|| Motion::new(&b,&s));
 let (_,c)=Operations::of(|| m.accelerations(&b,&Torques{roll:Counted(0.0),steer:Counted(1.0)}));
 println!("motion {a:?} {} acc {c:?} {}", a.total(), c.total());
}
