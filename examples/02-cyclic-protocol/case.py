"""A drift protocol on a column of the paper: the same as case.nml, in Python, with a figure."""

import sys

import rbsdem

column = rbsdem.peer.paper_columns(kinematics="pdelta")["soesianawati_1"]
drifts = [0.0025, 0.005, 0.01, 0.02, 0.03]
displacement = column.height * rbsdem.protocol(drifts, cycles=2)
result = rbsdem.cyclic(column, displacement=displacement)

print(f"peak force             {result.summary['peak_force'] / 1e3:8.1f} kN")
print(f"dissipated energy      {result.energy['spring'][-1] / 1e3:8.1f} kJ")
print(f"energy residual        {result.summary['relative_energy_residual']:8.0e}")

if "--no-plot" not in sys.argv:
    rbsdem.plot.save(rbsdem.plot.loop(result), "cyclic_protocol.png")
    print("wrote cyclic_protocol.png")
