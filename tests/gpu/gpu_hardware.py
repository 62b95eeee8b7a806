"""The GPUs of the model of GPU times. Rows stay fixed, so that tables can be compared."""
import dataclasses


@dataclasses.dataclass
class Hardware:
    name: str
    compute_units: int
    clock: float  # Hz
    simds: int
    dram: float  # bytes per second, like the next two
    cache: float
    l2: float
    fixed: float  # seconds per dependent dispatch
    valu: float  # clocks per instruction, like the next
    transcendental: float
    cache_hits: float  # fraction


RX_6800 = Hardware("RX 6800-class (60 CU, 2.1 GHz, 512 GB/s + 128 MB IC)", 60, 2.1e9, 120,
                   512e9, 1.1e12, 1.6e12, 4e-6, 2, 8, 0.55)
# A transfer of AMD counts: 4 partitions per SM, integer and conversion work shares issue slots.
NVIDIA_LIKE = Hardware("NVIDIA-like (46 SM, 1.7 GHz, 448 GB/s, 4 MB L2)", 46, 1.7e9, 184,
                       448e9, 448e9, 1.4e12, 3.5e-6, 2 * 1.45, 2 * 8, 0.0)
SMALL_RDNA2 = Hardware("small RDNA2 (28 CU, 2.3 GHz, 224 GB/s + 32 MB IC)", 28, 2.3e9, 56,
                       224e9, 0.5e12, 0.8e12, 4e-6, 2, 8, 0.2)
# Added before the first measurement on such a device; time per dispatch as above.
H200 = Hardware("H200 (132 SM, 1.98 GHz, 4.8 TB/s, 60 MB L2)", 132, 1.98e9, 528,
                4.8e12, 5.5e12, 5.5e12, 3.5e-6, 2 * 1.45, 2 * 8, 0.3)
H100 = Hardware("H100 (132 SM, 1.98 GHz, 3.35 TB/s, 50 MB L2)", 132, 1.98e9, 528,
                3.35e12, 5.5e12, 5.5e12, 3.5e-6, 2 * 1.45, 2 * 8, 0.25)
