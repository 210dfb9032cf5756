"""What accuracy costs in case.nml, and which parts of the model it needs."""

import sys
from pathlib import Path

import rbsdem

case = rbsdem.read_case(Path(__file__).with_name("case.nml"))
found = rbsdem.compare_methods(
    case.column,
    case.time,
    ground_acceleration=case.ground_acceleration,
    setting=case.solver,
    tolerance=1e-3,
    budget=20.0,
)

reference, physics = found.reference, found.physics
assert reference is not None  # the budget is large enough
assert physics is not None
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
for effect in physics.effects:
    changes = f"{100 * effect.peak:8.2f} {100 * effect.moment:14.2f} {100 * effect.energy:9.2f}"
    print(f"{changes}  {'matters' if effect.matters else '       '}  {effect.part}")

if "--no-plot" not in sys.argv:
    rbsdem.plot.save(rbsdem.plot.methods(found), "trade.png")
    print("wrote trade.png")
