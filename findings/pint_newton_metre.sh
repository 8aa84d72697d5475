#!/usr/bin/env bash
# Pint reads "Nm" as a measure of yarn, not as a newton metre, and gives no error.
#
# One would guess: a header "torque [Nm]" is a newton metre, or no unit at all (the table's spelling being N*m), as "Ncm" is.
# What happens: Nm is the metric yarn count, length over mass; 2 Nm are 2000 m/kg, and 5 mNm 5 m/kg. N.m and N*m are torques.
# Seen with: Pint 0.25.3
#   Nm  number_meter       2 Nm  = 2000.0 m/kg
#   mNm millinumber_meter  5 mNm =    5.0 m/kg
#   N.m newton metre       Ncm is undefined
# Why it matters: Nm is how most recordings write a torque. It parses, converts and multiplies without complaint; the fault
# shows only where a torque is asked for, and a ratio of two such columns never shows it.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m pip install --quiet --no-compile --disable-pip-version-check --target "$folder/site" pint==0.25.3
cd "$folder"
PYTHONNOUSERSITE=1 PYTHONPATH="$folder/site" python3 - <<'PY'
import pint

print("Pint", pint.__version__)
units = pint.UnitRegistry(cache_folder=None)
torque, yarn = units.newton * units.metre, units.metre / units.kilogram
for text in ("Nm", "mNm", "N.m"):
    parsed = units.parse_units(text)
    print(f"{text:4} is {parsed}, a torque: {parsed.is_compatible_with(torque)}; 1 {text} = {(1 * parsed).to_base_units()}")
try:
    print("Ncm is", units.parse_units("Ncm"))
    raise SystemExit("changed: Ncm is a unit")
except pint.UndefinedUnitError as error:
    print("Ncm:", error)
if (2 * units.parse_units("Nm")).to(yarn).magnitude != 2000.0 or units.parse_units("Nm").is_compatible_with(torque):
    raise SystemExit("changed: Nm is no longer a yarn count")
if abs((5 * units.parse_units("mNm")).to(yarn).magnitude - 5.0) > 1e-12:
    raise SystemExit("changed: mNm is no longer a yarn count")
if not units.parse_units("N.m").is_compatible_with(torque):
    raise SystemExit("changed: N.m is no torque")
PY
