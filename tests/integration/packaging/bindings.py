"""Makes bindings from the public headers only, like an author of bindings for another language.

Reads structs, enumerations and functions from the header and calls the library through them. With
an engine (bindings_engine.c as a library) the bindings also run a frame of a graph.

usage: bindings.py LIBRARY SOURCE_DIR [ENGINE]
"""
import ctypes
import re
import sys

library_path, source = sys.argv[1:3]
engine_path = sys.argv[3] if len(sys.argv) > 3 else None
header = "".join(
    open(f"{source}/integration/include/dermis/{name}.h", encoding="utf-8").read()
    for name in ("dermis", "choice"))
code = re.sub(r"/\*.*?\*/", "", header, flags=re.S)

plain = {
    "size_t": ctypes.c_size_t,
    "uint32_t": ctypes.c_uint32, "uint64_t": ctypes.c_uint64, "int32_t": ctypes.c_int32,
    "float": ctypes.c_float, "double": ctypes.c_double, "char": ctypes.c_char,
    # Vulkan types: 32-bit enumerations and flags, 64-bit flags, and handles as wide as pointers.
    "VkFormat": ctypes.c_int32, "VkImageLayout": ctypes.c_int32,
    "VkImageUsageFlags": ctypes.c_uint32,
    "VkPipelineStageFlags2": ctypes.c_uint64, "VkAccessFlags2": ctypes.c_uint64,
    "VkMemoryPropertyFlags": ctypes.c_uint32, "VkFilter": ctypes.c_int32,
    "VkClearColorValue": ctypes.c_uint32 * 4,
}
types = dict(plain)
for name in re.findall(r"typedef enum (\w+) \{", code):
    types[name] = ctypes.c_int32
enumerators = {name: int(value, 0) for name, value in re.findall(r"\b(DERMIS_\w+) = (-?\w+)", code)}


def type_of(text):
    """Returns the ctypes type of a declared type.

    All types except plain types and structs by value are pointers.
    """
    text = text.replace("const", " ").replace("struct", " ").strip()
    if text.endswith("*"):
        return ctypes.c_char_p if text.replace(" ", "") == "char*" else ctypes.c_void_p
    return types.get(text, ctypes.c_void_p)


for name, body in re.findall(r"typedef struct (\w+) \{(.*?)\} \1;", code, flags=re.S):
    fields = []
    for declaration in filter(None, (part.strip() for part in body.split(";"))):
        kind, names = re.match(r"((?:const )*\w+(?: const)?(?:\s*\*(?:\s*const\s*\*)?)?)\s*(.*)",
                               declaration, re.S).groups()
        for one in names.split(","):
            one = one.strip()
            count = re.search(r"\[(\d+)\]", one)
            field = re.match(r"\**\s*(?:const\s*\*?\s*)?(\w+)", one).group(1)
            made = type_of(kind + ("*" if one.startswith("*") else ""))
            fields.append((field, made * int(count.group(1)) if count else made))
    types[name] = type(name, (ctypes.Structure,), {"_fields_": fields})

library = ctypes.CDLL(library_path)
functions = re.findall(r"DERMIS_API (.+?)\s*DERMIS_CALL (\w+)\((.*?)\);", code, flags=re.S)
for result, name, arguments in functions:
    function = getattr(library, name)  # Fails if a declared function is missing.
    function.restype = None if result.strip() == "void" else type_of(result)
    function.argtypes = [
        ctypes.c_void_p if "*" in one else type_of(re.sub(r"\w+$", "", one.strip()))
        for one in arguments.split(",") if one.strip() != "void"]


def expect(condition, what):
    if not condition:
        sys.exit(f"bindings: {what}")


version = library.dermis_version()
expect(version >> 22 == int(re.search(r"DERMIS_VERSION_MAJOR (\d+)", code).group(1)),
       "another major version")
expect(library.dermis_result_name(enumerators["DERMIS_ERROR_CONFIG"]) == b"DERMIS_ERROR_CONFIG",
       "names of results")


def validate(text):
    """Returns the result and the messages (code name, line, text) of a graph."""
    given = types["dermis_source"]()
    given.struct_size = ctypes.sizeof(given)
    given.name, given.text, given.length = b"bound.json", text, len(text)
    report = ctypes.c_void_p()
    result = library.dermis_validate(ctypes.addressof(given), ctypes.addressof(report))
    said = []
    for index in range(library.dermis_report_count(report)):
        message = types["dermis_message"]()
        message.struct_size = ctypes.sizeof(message)
        expect(library.dermis_report_message(report, index, ctypes.addressof(message)) == 0,
               "a message that is refused")
        said.append((message.code_name.decode(), message.line, message.text.decode()))
    library.dermis_report_destroy(report)
    return result, said


graph = open(source + "/configs/graphs/burley.json", "rb").read()
expect(validate(graph) == (enumerators["DERMIS_OK"], []), "a shipped graph is refused")
result, said = validate(graph.replace(b'"name": "burley"', b'"nmae": "burley"'))
expect(result == enumerators["DERMIS_ERROR_CONFIG"], f"a misspelt key gives {result}")
expect(any(code == "unknown_key" and line == 4 for code, line, _ in said),
       f"the misspelt key is not named: {said}")
structs = sum(1 for one in types.values() if isinstance(one, type(ctypes.Structure)))
print(f"{len(functions)} functions and {structs} structs bound")


kept = []  # Keeps objects alive whose addresses are stored in structs.


def filled(struct, /, **fields):
    """Returns a struct of the interface, zero except for its size and `fields`."""
    made = types[struct]()
    kept.append(made)
    if hasattr(made, "struct_size"):
        made.struct_size = ctypes.sizeof(made)
    for field, value in fields.items():
        setattr(made, field, value)
    return made


def called(name, *arguments):
    result = getattr(library, name)(*arguments)
    expect(result == enumerators["DERMIS_OK"],
           f"{name} gives {result}: {library.dermis_last_error()}")


def source_of(name, text):
    return filled("dermis_source", name=name, text=text, length=len(text))


def run(engine, side=64):
    """Runs a frame of a lit wall of skin as in minimal.c; returns pass names and times in ns."""
    for name in ("instance", "gpu", "device", "commands", "loader"):
        getattr(engine, f"engine_{name}").restype = ctypes.c_void_p
    engine.engine_image.argtypes = [ctypes.c_int32, ctypes.c_uint32, ctypes.c_uint32,
                                    ctypes.c_float, ctypes.c_int32, ctypes.c_void_p]
    engine.engine_create()
    context, made = ctypes.c_void_p(), ctypes.c_void_p()
    called("dermis_context_create", ctypes.addressof(filled(
        "dermis_context_desc",
        abi_version=int(re.search(r"DERMIS_ABI_VERSION (\d+)", code).group(1)),
        flags=1, instance=engine.engine_instance(), physical_device=engine.engine_gpu(),
        device=engine.engine_device(), get_instance_proc_addr=engine.engine_loader())),
           ctypes.addressof(context))
    skin = open(source + "/configs/profiles/skin.json", "rb").read()
    profile = filled("dermis_profile", id=1, source=source_of(b"skin.json", skin))
    depth = filled("dermis_slot_format", name=b"depth", format=100)  # VK_FORMAT_R32_SFLOAT
    unbound = (ctypes.c_char_p * 3)(b"albedo", b"scatter_scale", b"scattered_light")
    called("dermis_graph_create", context, ctypes.addressof(filled(
        "dermis_graph_desc", source=source_of(b"burley.json", graph), width=side, height=side,
        profiles=ctypes.addressof(profile), profile_count=1,
        unbound=ctypes.addressof(unbound), unbound_count=3,
        formats=ctypes.addressof(depth), format_count=1)), ctypes.addressof(made), None)
    count = ctypes.c_uint32(16)
    slots = (types["dermis_slot"] * 16)(filled("dermis_slot"))
    called("dermis_graph_slots", made, ctypes.addressof(count), ctypes.addressof(slots))
    bindings = []
    for slot in list(slots)[:count.value]:
        if not slot.bound:
            continue
        handles = (ctypes.c_uint64 * 2)()
        value = {b"depth": 0.5}.get(slot.name, 1.0)
        engine.engine_image(slot.format, side, slot.usage, value, slot.name == b"material",
                            ctypes.addressof(handles))
        # ALL_COMMANDS, MEMORY_WRITE
        rests = filled("dermis_image_state", layout=1, stages=1 << 16, access=1 << 16)
        bindings.append(filled("dermis_image_binding", slot=slot.id, format=slot.format,
                               image=handles[0], view=handles[1], width=side, height=side,
                               before=rests, after=rests))
    bound = (types["dermis_image_binding"] * len(bindings))(*bindings)
    frame = filled("dermis_frame", command_buffer=engine.engine_commands(),
                   bindings=ctypes.addressof(bound), binding_count=len(bindings), frame_index=1,
                   depth_kind=enumerators["DERMIS_DEPTH_VIEW_UNITS"])
    for index, value in {0: 2.0, 5: -2.0, 10: -1.0, 11: -0.1, 14: -1.0}.items():
        frame.clip_from_view[index] = value
    view = library.dermis_graph_view(made)
    called("dermis_view_record", view, ctypes.addressof(frame))
    engine.engine_submit_and_wait()
    times = (types["dermis_pass_timing"] * 16)(filled("dermis_pass_timing"))
    count.value = 16
    called("dermis_view_timings", view, 1, ctypes.addressof(count), ctypes.addressof(times))
    out = {getattr(one, "pass").decode(): one.nanoseconds for one in list(times)[:count.value]}
    library.dermis_graph_destroy(made)
    library.dermis_context_destroy(context)
    engine.engine_destroy()
    return out


if engine_path:
    passes = run(ctypes.CDLL(engine_path))
    expect("classify" in passes and all(time > 0 for time in passes.values()),
           f"the frame ran {passes}")
    print(f"a frame of {len(passes)} passes, {sum(passes.values()) / 1e6:.3f} ms")
