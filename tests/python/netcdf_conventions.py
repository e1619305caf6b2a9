"""Checks NetCDF files by compliance-checker: the conventions, without a remark. Arguments: the files."""

import sys
import warnings

from compliance_checker.runner import CheckSuite, ComplianceChecker

warnings.simplefilter("ignore")
CheckSuite.load_all_available_checkers()
passed, failed = ComplianceChecker.run_checker(sys.argv[1:], ["cf:1.11"], verbose=0, criteria="strict")
sys.exit(not passed or failed)
