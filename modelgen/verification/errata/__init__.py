"""The errata of the paper, each shown live: the printed formula fails, the corrected one holds."""
