"""Bodies that pass through each other because no contact lists them: found after a run, on its samples.

Takes in a run and the manifest's table `unlisted`; gives out the pairs whose material overlapped, with the
time at which it was first seen. An overlap is claimed only with a point that lies in both materials.
"""
