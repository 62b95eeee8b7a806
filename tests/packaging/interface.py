"""Writes a C file with an empty body for every function that dermis.h declares: compiled with debug information it
describes the interface as the header has it, types and all, whatever the library was built with.
usage: interface.py SOURCE_DIR > interface.c"""
import re
import sys

header = open(sys.argv[1] + "/integration/include/dermis/dermis.h", encoding="utf-8").read()
code = re.sub(r"/\*.*?\*/", "", header, flags=re.S)
print("#include <dermis/dermis.h>\n")
for result, name, arguments in re.findall(r"^DERMIS_API ([\w\* ]+?)\s*DERMIS_CALL (\w+)\((.*?)\);", code, flags=re.S | re.M):
    names = re.findall(r"(\w+)\s*(?:,|$)", arguments) if arguments.strip() != "void" else []
    unused = "".join(f" (void){one};" for one in names)
    end = "" if result.strip() == "void" else " return 0;"
    print(f"{result} DERMIS_CALL {name}({' '.join(arguments.split())}) {{{unused}{end} }}")
