use crate::rig::*;
use motor::Ask;
#[test]
fn probe() {
    let mut rig = Rig::ready(|c| c.demand.slew_nm_s = 1e6);
    rig.machine.held = true;
    let r = rig.run(200, Ask::Torque(5.0));
    for (i, r) in r.iter().enumerate().take(60) {
        println!(
            "{i} {:.3} {:.3} iq {:.3} {:.3} want {:.3} {:?} {:?}",
            r.torque_nm, r.out.torque_nm, r.iq_a, r.out.iq_a, r.out.iq_wanted_a, r.out.duties, r.out.faults
        );
    }
    println!("{}", mean(&r[100..], |r| r.torque_nm));
}
