"""Bindings made from the header alone, as an author for another language would: structs, enumerations and functions are
read from dermis.h, and the library is called through them.
usage: bindings.py LIBRARY SOURCE_DIR"""
import ctypes
import re
import sys

library_path, source = sys.argv[1:3]
header = open(source + "/integration/include/dermis/dermis.h", encoding="utf-8").read()
code = re.sub(r"/\*.*?\*/", "", header, flags=re.S)

plain = {
    "size_t": ctypes.c_size_t, "uint32_t": ctypes.c_uint32, "uint64_t": ctypes.c_uint64, "int32_t": ctypes.c_int32,
    "float": ctypes.c_float, "double": ctypes.c_double, "char": ctypes.c_char,
    # Of Vulkan: 32-bit enumerations and flags, 64-bit flags, and handles, which are as wide as pointers here.
    "VkFormat": ctypes.c_int32, "VkImageLayout": ctypes.c_int32, "VkImageUsageFlags": ctypes.c_uint32,
    "VkPipelineStageFlags2": ctypes.c_uint64, "VkAccessFlags2": ctypes.c_uint64,
}
types = dict(plain)
for name in re.findall(r"typedef enum (\w+) \{", code):
    types[name] = ctypes.c_int32
enumerators = {name: int(value, 0) for name, value in re.findall(r"\b(DERMIS_\w+) = (-?\w+)", code)}


def type_of(text):
    """The ctypes type of a declaration's type; whatever is not plain and no struct by value is a pointer or handle."""
    text = text.replace("const", " ").replace("struct", " ").strip()
    if text.endswith("*"):
        return ctypes.c_char_p if text.replace(" ", "") == "char*" else ctypes.c_void_p
    return types.get(text, ctypes.c_void_p)


for name, body in re.findall(r"typedef struct (\w+) \{(.*?)\} \1;", code, flags=re.S):
    fields = []
    for declaration in filter(None, (part.strip() for part in body.split(";"))):
        kind, names = re.match(r"((?:const )*\w+(?: const)?(?:\s*\*(?:\s*const\s*\*)?)?)\s*(.*)", declaration, re.S).groups()
        for one in names.split(","):
            one = one.strip()
            pointer = one.startswith("*") or kind.rstrip().endswith("*")
            count = re.search(r"\[(\d+)\]", one)
            field = re.match(r"\**\s*(?:const\s*\*?\s*)?(\w+)", one).group(1)
            made = type_of(kind + ("*" if one.startswith("*") else "")) if pointer else type_of(kind)
            fields.append((field, made * int(count.group(1)) if count else made))
    types[name] = type(name, (ctypes.Structure,), {"_fields_": fields})

library = ctypes.CDLL(library_path)
functions = re.findall(r"DERMIS_API (.+?)\s*DERMIS_CALL (\w+)\((.*?)\);", code, flags=re.S)
for result, name, arguments in functions:
    function = getattr(library, name)  # every declared function is there
    function.restype = None if result.strip() == "void" else type_of(result)
    function.argtypes = [ctypes.c_void_p if "*" in one else type_of(re.sub(r"\w+$", "", one.strip()))
                         for one in arguments.split(",") if one.strip() != "void"]


def expect(condition, what):
    if not condition:
        sys.exit(f"bindings: {what}")


version = library.dermis_version()
expect(version >> 22 == int(re.search(r"DERMIS_VERSION_MAJOR (\d+)", code).group(1)), "another major version")
expect(library.dermis_result_name(enumerators["DERMIS_ERROR_CONFIG"]) == b"DERMIS_ERROR_CONFIG", "names of results")


def validate(text):
    """Result and messages (code name, line, text) of a graph."""
    given = types["dermis_source"]()
    given.struct_size = ctypes.sizeof(given)
    given.name, given.text, given.length = b"bound.json", text, len(text)
    report = ctypes.c_void_p()
    result = library.dermis_validate(ctypes.addressof(given), ctypes.addressof(report))
    said = []
    for index in range(library.dermis_report_count(report)):
        message = types["dermis_message"]()
        message.struct_size = ctypes.sizeof(message)
        expect(library.dermis_report_message(report, index, ctypes.addressof(message)) == 0, "a message that is refused")
        said.append((message.code_name.decode(), message.line, message.text.decode()))
    library.dermis_report_destroy(report)
    return result, said


graph = open(source + "/configs/graphs/burley.json", "rb").read()
expect(validate(graph) == (enumerators["DERMIS_OK"], []), "a shipped graph is refused")
result, said = validate(graph.replace(b'"name": "burley"', b'"nmae": "burley"'))
expect(result == enumerators["DERMIS_ERROR_CONFIG"], f"a misspelt key gives {result}")
expect(any(code == "unknown_key" and line == 4 for code, line, _ in said), f"the misspelt key is not named: {said}")
print(f"{len(functions)} functions and {sum(1 for t in types.values() if isinstance(t, type(ctypes.Structure)))} structs bound")
