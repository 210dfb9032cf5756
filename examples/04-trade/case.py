"""What accuracy costs in case.nml, and which parts of the model it needs."""

import sys
from pathlib import Path

import rbsdem

case = rbsdem.read_case(Path(__file__).with_name("case.nml"))
found = rbsdem.compare_methods(
    case.column,
    case.time,
    ground_acceleration=case.ground_acceleration,
    setting={"method": case.method, "dt": case.settings["dt"]},
    tolerance=1e-3,
    budget=20.0,
)

reference = found.reference
print(f"reference    {reference.first} and {reference.second}")
print(f"             agree to {reference.digits:.1f} digits in displacement")
own = found.rows[0]
print(f"as given     {own.setting}: {1e3 * own.seconds:.2f} ms, error {own.error:.1e}")
for tolerance in (1e-2, 1e-3, 1e-5, 1e-7):
    row = found.cheapest(tolerance)
    if row is not None:
        print(f"within {tolerance:.0e} {row.setting}: {1e3 * row.seconds:.2f} ms")
print(found.choice)

print("\nchange of     peak %  base moment %  energy %")
for effect in found.physics.effects:
    changes = f"{100 * effect.peak:8.2f} {100 * effect.moment:14.2f} {100 * effect.energy:9.2f}"
    print(f"{changes}  {'matters' if effect.matters else '       '}  {effect.part}")

if "--no-plot" not in sys.argv:
    axes = rbsdem.plot.methods(found)
    axes.figure.savefig("trade.png", dpi=150)
    print("wrote trade.png")
