"""Says which files a JSON schema refuses: controller_schema.py SCHEMA FILE…; a line for each, 'valid' or the first reason.

Exits with 77 where Debian's python3-jsonschema is not installed.
"""
import json
import sys

try:
    from jsonschema import Draft202012Validator
except ImportError:
    sys.exit(77)

with open(sys.argv[1], encoding="utf-8") as file:
    schema = json.load(file)
Draft202012Validator.check_schema(schema)
validator = Draft202012Validator(schema)


def refuse(constant):
    raise ValueError(constant + " is no number of JSON")


for name in sys.argv[2:]:
    try:
        with open(name, encoding="utf-8-sig") as file:
            instance = json.load(file, parse_constant=refuse)
    except ValueError as error:
        print("not JSON:", str(error).replace("\n", " "))
        continue
    reasons = [error.message for error in validator.iter_errors(instance)]
    print(reasons[0].replace("\n", " ") if reasons else "valid")
