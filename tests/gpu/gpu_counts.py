"""Counts of executed instructions per subgroup for gpu_model.py, with the names of Model.wave.

From ACO's assembly of navi21; branches count with their usual side, chosen by hand.
"""
import dataclasses

CLASSIFY = dict(valu=450, trans=15, img=34, vm=6, lg=15, W=12)
COMBINE = dict(valu=80, trans=3, img=2, st64=1, vm=2, W=16)
SETUP = dict(valu=260, trans=13, img=5, st64=2, vm=3, lg=20, W=16, lds=40)
# 12 taps to each side of 4 texels
SEPARABLE = dict(valu=130 + 12 * 13 + 48 * 85, trans=12 + 48 * 16, qmul=3, img=3 + 144, buf=26,
                 st64=1, vm=3 + 144, vml=140, lg=12, W=9)
SEPARABLE_TUNED = dict(valu=90 + 25 * 14, trans=6 + 25, img=2 + 25, st64=1, vm=2 + 5, vml=250,
                       lg=10, W=12)
# 25 taps at d = 4 px: 7 taps of each side in shared memory, 5 read light and depth
SEPARABLE_BUILT = dict(valu=605, trans=82, qmul=1, img=30, buf=6, st64=1, vm=14, vml=260, lg=50,
                       W=7, lds=340)
SEPARABLE_BUILT_SETUP = dict(valu=100, trans=3, img=3, st64=2, vm=3, lg=15, W=16)
BURLEY = dict(valu=100 + 32 * 115, trans=10 + 32 * 18, img=4, scat=32 * 4, st64=1,
              vm=3 + 96, vml=260, lg=40, W=10)
AFIS = dict(valu=430 + 16 * 420, trans=60 + 16 * 80, img=6, scat=16 * 9, st64=1,
            vm=4 + 16 * 6, vml=260, lg=60, W=8)
AFIS_PUBLISHED = dict(valu=125 + 16 * 91, trans=15 + 16 * 21, qmul=7, img=2, scat=16 * 2, st64=1,
                      vm=3 + 16, vml=260, lg=40, W=10)
AFIS_MIP_SETUP = dict(valu=170, img=4, img128=0, st64=1, vm=3, W=16)
AFIS_MIP_DOWN = dict(valu=140, trans=2, img=9, st64=1, vm=2, W=16)


def fixed(samples):
    return dict(valu=260 + samples * 150, trans=35 + samples * 32, img=4, scat=samples * 4, st64=1,
                vm=3 + samples * 3, vml=260, lg=30, W=9)


# One read of a mip chain per sample, as two reads: it interpolates between two mips.
def afis_built(samples):
    return dict(valu=200 + samples * 169, trans=45 + samples * 30, qmul=7, img=4, scat=samples * 6,
                st64=1, vm=4 + samples * 4, vml=260, lg=60, W=8)


# Once per pixel: reads of the history, the observed value, and writes of the history.
GUIDED_ONCE = {
    "spvg": dict(valu=500, trans=50, qmul=5, img=17, st64=3, vm=12, lg=44, W=8),
    "ccv": dict(valu=545, trans=55, qmul=5, img=18, st64=3, vm=13, lg=45, W=8),
    "ocv": dict(valu=620, trans=60, qmul=5, img=22, st64=4, vm=13, lg=46, W=7),
    "split_half": dict(valu=575, trans=60, qmul=6, img=13, st64=2, vm=11, lg=43, W=8),
}
GUIDE_BYTES = {"spvg": 10, "ccv": 10, "ocv": 18, "split_half": 8}  # of a pixel's histories
POOL = dict(valu=330, lg=18, lds=300)  # the mean over the pixels of a tile


def guided(samples, guidance, pooled=True):
    counts = dict(GUIDED_ONCE[guidance])
    counts["valu"] += samples * 172
    counts["trans"] += samples * 30
    counts["vm"] += samples * 4
    if pooled or guidance == "split_half":
        counts["valu"] += POOL["valu"]
        counts["lg"] += POOL["lg"]
        counts["lds"] = POOL["lds"]
    return dict(counts, scat=samples * 6, vml=260)


@dataclasses.dataclass
class Pyramid:
    """Counts of one implementation.

    slow_down(level), slow_up(level): counts of a subgroup with two layers; None: one layer.
    """
    setup: dict
    down: dict
    up: dict
    gather: dict
    texels_setup: int = 1  # per invocation
    texels: int = 1
    slow_down: object = None
    slow_up: object = None


def blocks_slow_down(level):
    k = 2 if level < 5 else 3  # parents with two layers in the slowest invocation
    return dict(valu=5600 + k * (1019 + 2 * 2467), trans=300 + k * 320, img=36 + k * 32,
                img128=36 + k * 32, st64=4, st128=4, vm=60 + k * 60, lg=322 + k * 430, W=2,
                scr=350 + k * 1000, code=84320)


def blocks_slow_up(level):
    k = 2 if level < 5 else 3
    return dict(valu=2950 + k * (520 + 2 * 920), trans=150 + k * 78, img=16 + k * 18,
                img128=24 + k * 30, st128=4, buf=25 + 12 * k, vm=30 + k * 40, lg=250 + k * 150,
                W=2, code=39804)


def texel_slow_down(_):
    return dict(valu=1175 + 2 * 2700, trans=75 + 2 * 230, img=5.1 + 8, img128=5.1 + 16, st64=2,
                st128=2, vm=6 + 20, lg=62 + 2 * 70, W=4, lds=2 * 64 * 10 + 300)


def texel_slow_up(_):
    return dict(valu=200 + 2 * 1016, trans=78, img=10, img128=20, st128=2, buf=14, vm=30, lg=140,
                W=7, lds=400)


BLOCKS = Pyramid(
    setup=dict(valu=1900, trans=140, img=48, st64=8, st128=8, vm=65 * 0.5, lg=104, W=7),
    down=dict(valu=5000, trans=270, img=36, img128=36, st64=4, st128=4, vm=49, lg=322, W=2,
              scr=345, code=47144),
    up=dict(valu=3150, trans=140, img=16, img128=24, st128=4, buf=25, vm=29, lg=234, W=2,
            code=28980),
    gather=dict(valu=5100, trans=260, img=24, img128=24 + 24, st64=8, buf=81, vm=126, vml=240,
                lg=253, W=2, scr=191, code=42568),
    texels_setup=8, texels=4, slow_down=blocks_slow_down, slow_up=blocks_slow_up)
TEXELS = Pyramid(
    setup=dict(valu=330, trans=18, img=4, st64=1, st128=1, vm=4, lg=20, W=16, lds=30),
    down=dict(valu=1175, trans=75, qmul=12, img=5.1, img128=5.1, st64=1, st128=1, vm=6, lg=42 + 20,
              W=4, lds=16 * 12 + 4 * 8 + 6 * 12),
    up=dict(valu=900, trans=38, qmul=10, img=1.6, img128=1.6 + 0.8, st128=1, buf=8, vm=8, lg=45,
            W=8, lds=9 * 12 + 8 * 8 + 2 * 12),
    gather=dict(valu=730, trans=35, qmul=10, img=1.6, img128=1.6 + 1.2, st64=1, buf=12, vm=8,
                lg=39, W=7, lds=9 * 12 + 8 * 8 + 2 * 12),
    slow_down=texel_slow_down, slow_up=texel_slow_up)

# How often the loops of a kernel run, in the order of the assembly, for subgroups with two layers.
# Loops over outer seeds are rare: 0, but the second half of a group of sap_coarse_down searches the
# second layer of all texels. The children of the second pipeline of sap_down have one layer.
TRIPS = {"sap_setup": [2], "sap_down": [2, 4, 4, 0, 0, 4, 4, 4, 4, 0, 0, 4, 4],
         "sap_down second_surface=unbound": [2, 4, 0, 4, 4, 0, 4], "sap_up": [2],
         # four levels, one after another; a tile is read by one of two loops; two searches for
         # outer seeds
         "sap_coarse_down": [1, 1, 4, 1, 1, 8, 8, 1, 1],
         "sap_coarse_up": [1, 2, 1, 1, 5, 1]}  # five levels
# The same for subgroups with one layer. Their way down is that of level 1 at every level, without
# the branch for the second layer.
ONE_LAYER_TRIPS = {"sap_down": [2, 4, 0, 4, 0, 0, 0], "sap_up": [1], "sap_gather": []}
# The way down to level 2 where the children have one layer.
ONE_LAYER_CHILDREN_TRIPS = [2, 4, 0, 0, 0, 4, 0, 4, 0, 0, 0, 4, 0]
